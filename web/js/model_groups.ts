/** Groups of models and lights, which are selected and moved together. Pure. */
import type {World} from './protocol.js';

/** A model or light. */
type Member = {name: string, group: string};

/** The models and lights of a world, in its order. */
export const membersOf = (document: World|null): Member[] =>
  (document ? [...document.models, ...document.lights] : []);

/** The names of the models and lights in each group, in the order of the world. */
export function groupsOf(members: Member[]): Map<string, string[]> {
  const groups: Map<string, string[]> = new Map();
  for (const {name, group} of members) {
    if (group) groups.set(group, [...(groups.get(group) ?? []), name]);
  }
  return groups;
}

/** The names, each followed by the others of its group; names of links stay. */
export function withGroups(members: Member[], names: string[]): string[] {
  const groups = groupsOf(members);
  const groupOf = new Map(members.map(({name, group}) => [name, group]));
  return [...new Set(names.flatMap((name) => {
    const group = groupOf.get(name);
    return [name, ...(group && groups.get(group) || [])];
  }))];
}

/** The names with the others of their groups, the given name last: tools act on the last one. */
export const groupAround = (members: Member[], name: string) =>
  [...withGroups(members, [name]).filter((one) => one !== name), name];
