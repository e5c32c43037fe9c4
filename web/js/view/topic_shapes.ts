/** What the view draws of one ROS message: laser fans, points, paths, markers. */
import {
  BoxGeometry, BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, DataTexture,
  DoubleSide, Group, InstancedMesh, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshBasicMaterial, NearestFilter, PlaneGeometry, Points, PointsMaterial, RGBAFormat, SphereGeometry,
  Vector3,
} from 'three';
import {arrow, ball, segments, through, triad} from './markers.js';
import {fanOf} from '../topics/laser_fan.js';
import {label} from './label_sprite.js';
import {colorOf, place} from './three_convert.js';
import type {Material, Object3D} from 'three';
import type {
  ContactsView, MapView, Marker, PathView, PointsView, RangeView, ScanView,
} from '../protocol.js';
import type {Numbers, Vec3} from '../pose.js';

/** Colours that tell topics apart, the first ones of lasers as gzclient's. */
export const TOPIC_COLORS = Object.freeze([0x3b82f6, 0xf97316, 0x22c55e, 0xe11d48, 0xa855f7, 0x14b8a6]);

/** Shared by all messages: a material of its own for each would be compiled for each. */
const materials: Map<string, Material> = new Map();

function material<T extends Material>(Kind: new (options: object) => T, options: Record<string,
    unknown>): T {
  const key = `${Kind.name} ${JSON.stringify(options)}`;
  let found = materials.get(key);
  if (!found) {
    if (materials.size > 500) materials.clear();
    materials.set(key, found = new Kind({fog: false, ...options}));
  }
  return found as T;
}

const contactMaterial = through(0xef4444, 0.9);
const normalMaterial = new LineBasicMaterial({color: 0xfacc15, depthTest: false, transparent: true});

export function scanShape(scan: ScanView, ranges: Numbers, color: number) {
  const {corners, triangles, hits} = fanOf(scan, ranges);
  const fan = new BufferGeometry();
  fan.setAttribute('position', new BufferAttribute(corners, 3));
  fan.setIndex(triangles);
  const sheet = new Mesh(fan, material(MeshBasicMaterial, {color, opacity: 0.22, transparent: true,
    depthWrite: false, side: DoubleSide}));
  sheet.renderOrder = 40;
  const group = new Group();
  group.add(sheet, dots(new Float32Array(hits), material(PointsMaterial, {color, size: 4,
    sizeAttenuation: false})));
  return group;
}

export function pointsShape({count, colored}: PointsView, buffer: ArrayBuffer, start: number,
    color: number) {
  const made = dots(new Float32Array(buffer, start, 3 * count), material(PointsMaterial,
    {size: 3, sizeAttenuation: false, vertexColors: colored, ...(colored ? {} : {color})}));
  if (colored) {
    made.geometry.setAttribute('color', new BufferAttribute(
      new Uint8Array(buffer, start + 12 * count, 3 * count), 3, true));
  }
  return made;
}

function dots(positions: Float32Array, looks: PointsMaterial) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  return new Points(geometry, looks);
}

/** The cone of a sonar or infrared range finder, along x. */
export function rangeShape({range, range_max, field_of_view}: RangeView, color: number) {
  const length = range ?? range_max;
  const radius = length * Math.tan(Math.min(field_of_view, 3) / 2);
  const cone = new ConeGeometry(radius, length, 24, 1, true)
    .translate(0, -length / 2, 0).rotateZ(Math.PI / 2);
  return new Mesh(cone, material(MeshBasicMaterial, {color, opacity: range === null ? 0.08 : 0.3,
    transparent: true, depthWrite: false, side: DoubleSide}));
}

export function trailShape(points: Vec3[], color: number) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat()), 3));
  const made = new Line(geometry, material(LineBasicMaterial, {color}));
  made.renderOrder = 45;
  return made;
}

export function pathShape({poses, line}: PathView, color: number) {
  const group = new Group();
  if (line) group.add(trailShape(poses.map((pose) => pose.slice(0, 3)), color));
  for (const pose of line ? poses.slice(-1) : poses.slice(0, 300)) {
    const axes = triad(0.2);
    place(axes, pose);
    group.add(axes);
  }
  return group;
}

export function contactsShape({positions, normals}: ContactsView) {
  const group = new Group();
  for (const position of positions) {
    const mark = new Mesh(ball, contactMaterial);
    mark.position.fromArray(position);
    mark.scale.setScalar(0.015);
    mark.renderOrder = 53;
    group.add(mark);
  }
  const lines = positions.flatMap((position, index) =>
    [position, position.map((part, axis) => part + 0.2 * (normals[index]?.[axis] ?? 0))]);
  if (lines.length) group.add(segments(lines, normalMaterial));
  return group;
}

/** A map on its plane: free light, occupied dark, unknown clear. */
export function mapShape({width, height, resolution, pose}: MapView, cells: Uint8Array) {
  const pixels = new Uint8Array(4 * width * height);
  cells.forEach((cell, index) => {
    const grey = cell > 100 ? 0 : 235 - 2.2 * cell;
    pixels.set([grey, grey, grey, cell > 100 ? 0 : 190], 4 * index);
  });
  const map = new DataTexture(pixels, width, height, RGBAFormat);
  map.magFilter = NearestFilter;
  map.needsUpdate = true;
  const [wide, high] = [width * resolution, height * resolution];
  const sheet = new Mesh(new PlaneGeometry(wide, high).translate(wide / 2, high / 2, 0.005),
    new MeshBasicMaterial({map, transparent: true, depthWrite: false, side: DoubleSide, fog: false}));
  const group = new Group();
  place(group, pose);
  sheet.userData.texture = map;
  group.add(sheet);
  return group;
}

/** Axes with their name. */
export function frameShape(name: string, size: number) {
  const group = new Group();
  group.add(triad(size), label(name));
  return group;
}

/** Shapes whose points may have colours of their own. */
const POINTED = new Set(['line_strip', 'line_list', 'points', 'triangle_list', 'cube_list', 'sphere_list']);

/**
 * A visualization_msgs/Marker about its own pose. As in rviz the colours of points, where there is
 * one for each, stand for that of the marker, and what is wholly transparent is not drawn.
 */
export function markerShape(marker: Marker): Object3D {
  const [r, g, b, a] = marker.color;
  const color = (r * 255 << 16) + (g * 255 << 8) + (b * 255 | 0);
  const vertexColors = POINTED.has(marker.shape) && marker.colors.length > 0 &&
    marker.colors.length === marker.points.length;
  const opacity = vertexColors ? Math.max(...marker.colors.map((one) => one[3])) : a;
  if (opacity <= 0) return new Group();
  const looks = {opacity, transparent: opacity < 1, vertexColors,
    color: vertexColors ? 0xffffff : color};
  const [x, y, z] = marker.scale;
  const size = new Vector3(x || 1e-3, y || 1e-3, z || 1e-3);
  const solid = () => material(MeshBasicMaterial, {...looks, vertexColors: false});
  const sized = (geometry: BufferGeometry) => {
    const mesh = new Mesh(geometry, solid());
    mesh.scale.copy(size);
    return mesh;
  };
  /** One at each point, drawn at once. */
  const many = (geometry: BufferGeometry) => {
    const mesh = new InstancedMesh(geometry, solid(), marker.points.length);
    const matrix = new Matrix4();
    marker.points.forEach(([px, py, pz], index) => {
      mesh.setMatrixAt(index, matrix.makeScale(size.x, size.y, size.z).setPosition(px, py, pz));
      if (vertexColors) mesh.setColorAt(index, colorOf(marker.colors[index]));
    });
    return mesh;
  };
  const lines = () => material(LineBasicMaterial, looks);
  switch (marker.shape) {
    case 'sphere': return sized(new SphereGeometry(0.5, 20, 14));
    case 'cylinder': return sized(new CylinderGeometry(0.5, 0.5, 1, 24).rotateX(Math.PI / 2));
    case 'arrow': return arrowShape(marker, solid());
    case 'line_strip': return colored(marker, new Line(pointsOf(marker), lines()));
    case 'line_list': return colored(marker, new LineSegments(pointsOf(marker), lines()));
    case 'points': return colored(marker, new Points(pointsOf(marker),
      material(PointsMaterial, {size: Math.max(x, 1e-3), ...looks})));
    case 'triangle_list': return colored(marker, new Mesh(pointsOf(marker),
      material(MeshBasicMaterial, {side: DoubleSide, ...looks})));
    case 'cube_list': return many(new BoxGeometry(1, 1, 1));
    case 'sphere_list': return many(new SphereGeometry(0.5, 12, 8));
    case 'text': return label(marker.text, `#${color.toString(16).padStart(6, '0')}`);
    default: return sized(new BoxGeometry(1, 1, 1));
  }
}

/** Between two points, else along x with the length of the scale. */
function arrowShape({points, scale}: Marker, looks: MeshBasicMaterial) {
  const [from, to] = points.length === 2 ? points : [[0, 0, 0], [scale[0], 0, 0]];
  const way = to.map((part, axis) => part - from[axis]);
  const made = arrow(way, looks);
  made.position.fromArray(from);
  made.scale.setScalar(Math.hypot(...way) || 1e-3);
  return made;
}

function pointsOf({points}: Marker) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flat()), 3));
  return geometry;
}

/** Colours of the points, where the marker has them. */
function colored<T extends Mesh|Line|Points>({points, colors}: Marker, made: T) {
  if (colors.length !== points.length || !colors.length) return made;
  made.geometry.setAttribute('color', new BufferAttribute(
    new Float32Array(colors.flatMap((color) => color.slice(0, 3))), 3));
  return made;
}
