/** What can be plotted: values of the world and numbers of ROS topics. Pure. */
import type {Topic, World} from '../protocol.js';

const STATE = ['x', 'y', 'z', 'roll', 'pitch', 'yaw', 'vx', 'vy', 'vz', 'wx', 'wy', 'wz'];

/** Everything of a world that can be plotted, by owner. */
export function variablesOf(document: World|null): {owner: string, variables: string[]}[] {
  const groups = [{owner: 'Simulation', variables: ['sim_time', 'real_time_factor', 'iterations']}];
  for (const model of document?.models ?? []) {
    const of = (name: string) => STATE.map((part) => `${name}.${part}`);
    const variables = of(model.name);
    if (model.links.length > 1) {
      for (const link of model.links) variables.push(...of(`${model.name}::${link.name}`));
    }
    for (const joint of model.joints) {
      if (!joint.axis) continue;
      const parts = joint.axis2 ? ['position', 'rate', 'position2', 'rate2'] : ['position', 'rate'];
      variables.push(...parts.map((part) => `${model.name}::${joint.name}.${part}`));
    }
    groups.push({owner: model.name, variables});
  }
  return groups;
}

/**
 * The published ROS topics, each followed by the variables of its numbers if these are known.
 * @param fields  by topic
 */
export const topicVariables = (topics: Topic[], fields: Map<string, string[]>) =>
  topics.filter(({publishers}) => publishers > 0).flatMap(({name}) => [
    name, ...(fields.get(name) ?? []).map((field) => `${name}.${field}`)]);

/** Whether a variable is a number of a ROS topic; a topic's name alone is not. */
export const isTopicField = (variable: string) => /^\/[^.]+\.\w/.test(variable);
