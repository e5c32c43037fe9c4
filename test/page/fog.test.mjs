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
const {gazeboFog} = await import('../../web/js/view/shader_chunks.js');

// As three's.
ShaderChunk.fog_fragment = `float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
  float evenFactor = smoothstep( fogNear, fogFar, vFogDepth );`;
gazeboFog();
const shaders = {exp: Math.exp, max: Math.max,
  clamp: (value, low, high) => Math.min(Math.max(value, low), high)};
const [squared, even] = ['fogFactor', 'evenFactor'].map((name) => {
  const [, factor] = ShaderChunk.fog_fragment.match(new RegExp(`${name} = (.*);`));
  return new Function(...Object.keys(shaders), 'fogDensity', 'fogNear', 'fogFar', 'vFogDepth', `return ${factor};`)
    .bind(null, ...Object.values(shaders));
});

/** The part of what is seen at a distance (m) that is fog. */
function foggy(type, density, distance, [start, end] = [1, 100]) {
  const store = new Store();
  const scene = new Scene();
  new Surroundings({store, stage: {scene, invalidate() {}, shadowsChanged() {}},
    materials: {get: () => null, setDistance() {}}});
  const fog = {type, density, color: [1, 1, 1, 1], start, end};
  store.receive({type: 'world', revision: 1, document: {...world(),
    scene: {ambient: [1, 1, 1, 1], background: [1, 1, 1, 1], fog}}});
  const made = scene.fog;
  return (type === 'linear' ? even : squared)(made.density, made.near, made.far, distance);
}

test('exp and exp2 are dense as in Gazebo', () => {
  near([foggy('exp', 0.1, 20), foggy('exp2', 0.1, 20)], [1 - Math.exp(-2), 1 - Math.exp(-4)]);
  near([foggy('exp', 0, 20), foggy('exp', -1, 20), foggy('exp2', -1, 20)], [0, 0, 0]);
});

test('linear fog grows evenly from its start to its end', () => {
  near([4, 10, 17.5, 25, 40].map((distance) => foggy('linear', 1, distance, [10, 40])), [0, 0, 0.25, 0.5, 1]);
  near([4, 6].map((distance) => foggy('linear', 1, distance, [5, 5])), [0, 1]);
});
