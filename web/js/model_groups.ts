/** Groups of models, which are selected and moved together. Pure. */
import type {Model} from './protocol.js';

/** The names of the models in each group, in the order of the world. */
export function groupsOf(models: Model[]): Map<string, string[]> {
  const groups: Map<string, string[]> = new Map();
  for (const {name, group} of models) {
    if (group) groups.set(group, [...(groups.get(group) ?? []), name]);
  }
  return groups;
}

/** The names, each followed by the other models of its group; names of links and lights stay. */
export function withGroups(models: Model[], names: string[]): string[] {
  const groups = groupsOf(models);
  const groupOf = new Map(models.map(({name, group}) => [name, group]));
  return [...new Set(names.flatMap((name) => {
    const group = groupOf.get(name);
    return [name, ...(group && groups.get(group) || [])];
  }))];
}

/** The names with the groups' other models, the given name last: tools act on the last one. */
export const groupAround = (models: Model[], name: string) =>
  [...withGroups(models, [name]).filter((one) => one !== name), name];
