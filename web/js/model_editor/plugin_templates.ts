/** Plugins that the model editor offers, filled in with the joints of the model. Pure. */
import {compose, orientation, rotate} from '../pose.js';
import {freeName} from '../scoped_names.js';
import type {Joint, Link, Model} from '../protocol.js';

/** A turning joint with its child link; `backward`: its axis points to the right. */
type Wheel = {name: string, link: Link, backward: boolean};

const TURNING = ['revolute', 'continuous'];

/** The wheels of a model on one side of its x axis, front ones first. */
function wheelsOf({joints, links}: Model, side: 1|-1): Wheel[] {
  const found = joints.flatMap(({name, type, child, pose, axis}: Joint) => {
    const link = links.find((one) => one.name === child);
    if (!TURNING.includes(type) || !link || !axis || Math.sign(link.pose[1]) !== side) return [];
    return [{name, link, backward: rotate(orientation(compose(link.pose, pose)), axis.xyz)[1] < 0}];
  });
  return found.sort((a, b) => b.link.pose[0] - a.link.pose[0]);
}

function radiusOf({collisions}: Link) {
  const shape = collisions[0]?.geometry;
  return shape && 'radius' in shape ? shape.radius : 0.1;
}

const rounded = (value: number) => String(Number(value.toFixed(6)));

/** The track and diameter of two wheels as elements. */
const sizes = ([left]: Wheel[], [right]: Wheel[]) => left && right ? {
  wheelSeparation: rounded(left.link.pose[1] - right.link.pose[1]), wheelDiameter: rounded(2 * radiusOf(left.link)),
} : {wheelSeparation: '0.4', wheelDiameter: '0.2'};

/** What both drives publish and receive. */
const topics = ({links}: Model) => ({commandTopic: 'cmd_vel', odometryTopic: 'odom', odometryFrame: 'odom',
  robotBaseFrame: links[0]?.name ?? 'base_link', updateRate: '50'});

const jointName = (wheel: Wheel|undefined, missing: string) => wheel?.name ?? missing;

const MAKERS: {title: string, name: string, filename: string, elements: (model: Model) => Record<string, string>}[] = [
  {title: 'differential drive', name: 'drive', filename: 'libgazebo_ros_diff_drive.so', elements: (model) => {
    const [left, right] = [wheelsOf(model, 1), wheelsOf(model, -1)];
    return {leftJoint: jointName(left[0], 'LEFT_JOINT'), rightJoint: jointName(right[0], 'RIGHT_JOINT'),
      ...sizes(left, right), wheelTorque: '5', wheelAcceleration: '2', ...topics(model)};
  }},
  {title: 'skid steer drive', name: 'drive', filename: 'libgazebo_ros_skid_steer_drive.so', elements: (model) => {
    const [left, right] = [wheelsOf(model, 1), wheelsOf(model, -1)];
    return {leftFrontJoint: jointName(left[0], 'LEFT_FRONT_JOINT'), rightFrontJoint: jointName(right[0], 'RIGHT_FRONT_JOINT'),
      leftRearJoint: jointName(left[1], 'LEFT_REAR_JOINT'), rightRearJoint: jointName(right[1], 'RIGHT_REAR_JOINT'),
      ...sizes(left, right), torque: '5', ...topics(model), broadcastTF: 'true'};
  }},
  {title: 'joint states', name: 'joint_states', filename: 'libgazebo_ros_joint_state_publisher.so', elements: ({joints}) =>
    ({jointName: joints.filter(({axis}) => axis).map(({name}) => name).join(', '), updateRate: '50'})},
];

export const PLUGIN_TITLES = MAKERS.map(({title}) => title);

/**
 * The text of a plugin for a model; names in capitals stand for joints that it does not have.
 * @param title  one of `PLUGIN_TITLES`
 * @param text  the plugins that the model has: no two have one name
 */
export function pluginFor(title: string, model: Model, text: string): string {
  const maker = MAKERS.find((one) => one.title === title);
  if (!maker) throw new RangeError(`no plugin ${title}`);
  const name = freeName(maker.name, (one) => text.includes(`name="${one}"`));
  const elements = maker.elements(model);
  const backward = [...wheelsOf(model, 1), ...wheelsOf(model, -1)].filter((one) => one.backward);
  const remark = backward.length && 'wheelSeparation' in elements
    ? `  <!-- ${backward.map((one) => one.name).join(', ')}: the axis points to the right, so positive rates drive backwards; reverse it -->\n` : '';
  const inner = remark + Object.entries(elements).map(([key, value]) => `  <${key}>${value}</${key}>\n`).join('');
  return `<plugin name="${name}" filename="${maker.filename}">\n${inner}</plugin>`;
}
