/** Groups of models, which are selected and moved together. Pure. */
/** @import {Model} from './protocol.js' */

/**
 * The names of the models in each group, in the order of the world.
 * @param {Model[]} models
 * @returns {Map<string, string[]>}
 */
export function groupsOf(models) {
  /** @type {Map<string, string[]>} */
  const groups = new Map();
  for (const {name, group} of models) {
    if (group) groups.set(group, [...(groups.get(group) ?? []), name]);
  }
  return groups;
}

/**
 * The names, each followed by the other models of its group; names of links and lights stay.
 * @param {Model[]} models
 * @param {string[]} names
 * @returns {string[]}
 */
export function withGroups(models, names) {
  const groups = groupsOf(models);
  const groupOf = new Map(models.map(({name, group}) => [name, group]));
  return [...new Set(names.flatMap((name) => {
    const group = groupOf.get(name);
    return [name, ...(group && groups.get(group) || [])];
  }))];
}

/**
 * The names with the groups' other models, the given name last: tools act on the last one.
 * @param {Model[]} models
 * @param {string} name
 */
export const groupAround = (models, name) =>
  [...withGroups(models, [name]).filter((one) => one !== name), name];
