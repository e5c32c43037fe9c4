/** Fog: how much is seen through it at a distance. */
import {test} from 'node:test';
import {Store} from '../../web/js/store.js';
import {world} from './scene.mjs';
import {near} from './near.mjs';
import {installPlainDom} from './plain_dom.mjs';
import './with_plain_three.mjs';

installPlainDom();
const {Scene, ShaderChunk} = await import('three');
const {Surroundings} = await import('../../web/js/view/environment.js');
const {exponentialFog} = await import('../../web/js/view/shader_chunks.js');

// As three's.
ShaderChunk.fog_fragment = `float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );`;
exponentialFog();
const [, factor] = ShaderChunk.fog_fragment.match(/fogFactor = (.*);/);
const fogFactor = new Function('exp', 'fogDensity', 'vFogDepth', `return ${factor};`);

/** The part of what is seen at a distance (m) that is fog. */
function foggy(type, density, distance) {
  const store = new Store();
  const scene = new Scene();
  new Surroundings({store, stage: {scene, invalidate() {}, shadowsChanged() {}},
    materials: {get: () => null, setDistance() {}}});
  const fog = {type, density, color: [1, 1, 1, 1], start: 1, end: 100};
  store.receive({type: 'world', revision: 1, document: {...world(),
    scene: {ambient: [1, 1, 1, 1], background: [1, 1, 1, 1], fog}}});
  return fogFactor(Math.exp, scene.fog.density, distance);
}

test('exp and exp2 are dense as in Gazebo', () => {
  near([foggy('exp', 0.1, 20), foggy('exp2', 0.1, 20)], [1 - Math.exp(-2), 1 - Math.exp(-4)]);
  near([foggy('exp', 0, 20), foggy('exp', -1, 20), foggy('exp2', -1, 20)], [0, 0, 0]);
});
