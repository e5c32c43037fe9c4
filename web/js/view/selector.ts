/** What clicks select, and where the ray under the mouse meets the world. */
import {Mesh} from 'three';
import {groupAround, membersOf} from '../model_groups.js';
import {rayPlane, WORLD_AXES} from '../drag_math.js';
import {add, length, scale, subtract} from '../pose.js';
import {ViewPart} from './view_part.js';
import type {MousePoint} from './pointer.js';
import type {Vec3} from '../pose.js';

/** What is under the mouse. */
export type Under = {name: string, link?: string, point: Vec3, plane?: boolean};

/** Metres ahead of where nothing is, and to where the ground is taken for near the horizon. */
const AHEAD = 10;
const FAR = 30;

export class Selector extends ViewPart {

  /** @param accept  whether a model or light is wanted */
  under({clientX, clientY}: MousePoint, accept: (name: string) => boolean = () => true):
      {name: string, link?: string, point: number[], plane?: boolean}|null {
    const body = this.picker.nearest(this.batches.items(), clientX, clientY,
      (owner) => owner.model !== undefined && accept(owner.model));
    const icons = new Map([...this.lights.icons].filter(([name]) => accept(name)));
    const [light] = this.picker.objects([...icons.values()], clientX, clientY)
      .filter(({object}) => object instanceof Mesh);
    if (light && (!body || light.distance < body.distance)) {
      const found = [...icons].find(([, icon]) => icon === light.object.parent);
      if (found) return {name: found[0], point: light.point.toArray()};
    }
    if (!body) return null;
    const {model, link, plane} = body.owner;
    return {name: model, link, point: body.point, plane};
  }

  /** Returns the model that a drag can move; locked models are skipped. */
  movable(event: MousePoint) {
    const hit = this.under(event, (name) => !this.store.overlay('locked', name));
    return hit && !hit.plane ? hit : null;
  }

  /** A drag moves the nearest model or light, unless it is locked; of the model that is being built, the link. */
  grasped(event: MousePoint) {
    const nearest = this.under(event);
    const hit = nearest && !nearest.plane && !this.store.overlay('locked', nearest.name) ? nearest : null;
    const built = hit?.link && this.store.modelEditing?.name === hit.name;
    return hit && built ? {...hit, name: `${hit.name}::${hit.link}`} : hit;
  }

  /** Links are offered for a joint: all under the mouse, nearest first. */
  pick({clientX, clientY}: MousePoint) {
    const hits = this.picker.all(this.batches.items(), clientX, clientY,
      (owner) => owner.model !== undefined && !owner.plane);
    const links = hits.flatMap(({owner: {model, link}}) => (model && link ? [{model, link}] : []));
    if (links.length) this.store.emit('pick', links);
  }

  /** The point under the mouse: of a body, of the ground, or 10 m ahead. */
  point(event: MousePoint) {
    const hit = this.under(event);
    if (hit && !hit.plane) return hit.point;
    const ray = this.picker.ray(event.clientX, event.clientY);
    const ground = hit?.point ?? rayPlane(ray, [0, 0, 0], WORLD_AXES.z);
    const distance = ground ? length(subtract(ground, ray.origin)) : AHEAD;
    return add(ray.origin, scale(ray.direction, Math.min(distance, FAR)));
  }

  click(event: MousePoint) {
    const hit = this.movable(event);
    const several = event.ctrlKey || event.metaKey;
    if (!hit) {
      if (!several) this.store.select([]);
      return;
    }
    const group = this.#group(hit.name);
    if (several) this.store.select(group, this.store.selection.includes(hit.name) ? {toggle: true} : {add: true});
    else if (this.#wantsLink(hit)) this.store.select([`${hit.name}::${hit.link}`]);
    else this.store.select(this.#wantsMember(group) ? [hit.name] : group);
  }

  /** The members of the group of a model or light that the mouse reaches, this one last. */
  #group(name: string) {
    return groupAround(membersOf(this.store.document), name)
      .filter((one) => one === name || !this.store.overlay('locked', one));
  }

  /** The second click on a group means one of its members. */
  #wantsMember(group: string[]) {
    const {selection} = this.store;
    return group.length > 1 && group.every((name) => selection.includes(name)) ||
      selection.length === 1 && group.includes(selection[0]);
  }

  /** The second click on a model of several links means the link. */
  #wantsLink({name, link}: Under) {
    const {selection, mode, modelEditing} = this.store;
    if (link && modelEditing?.name === name) return true;
    const [chosen] = selection;
    const model = this.store.model(name);
    return mode === 'select' && link && selection.length === 1 && model && model.links.length > 1 &&
      this.store.split(chosen)[0]?.name === name;
  }

  menu(event: MousePoint) {
    const hit = this.movable(event);
    if (hit && !this.store.selection.includes(hit.name)) this.store.select(this.#group(hit.name));
    this.store.emit('contextmenu',
      {name: hit?.name ?? null, x: event.clientX, y: event.clientY});
  }

  flyTo(event: MousePoint) {
    if (this.store.mode === 'insert') return;
    const hit = this.movable(event);
    const box = hit && this.models.bounds(hit.name);
    if (box) this.rig.flyTo(box);
    else this.rig.flyTowards(this.point(event));
  }
}
