/**
 * Surfaces are drawn from both sides, since many files leave their back faces to the viewer. Others
 * have every face twice, once for each side at the same place (SketchUp writes them so, and Gazebo
 * leaves out what is seen from behind): there the face that is seen from its front must win.
 */
import type {Material} from 'three';

/**
 * Pushes what is seen from behind away by a few steps of the depth buffer, which has 24 bits.
 * The normal of the vertex tells, as the sides of a triangle are known too late for its depth.
 */
const BEHIND = `#include <project_vertex>
{
  vec3 outwards = normal;
  #ifdef USE_INSTANCING
    outwards = mat3(instanceMatrix) * outwards;
  #endif
  vec3 sight = isPerspectiveMatrix(projectionMatrix) ? mvPosition.xyz : vec3(0.0, 0.0, -1.0);
  if (dot(normalMatrix * outwards, sight) > 0.0) gl_Position.z += 1.0e-6 * gl_Position.w;
}`;

/**
 * Lets faces that are seen from the front win against those at the same place seen from behind.
 * @param material  drawn from both sides
 * @returns the same
 */
export function frontsFirst<T extends Material>(material: T): T {
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace('#include <project_vertex>', BEHIND);
  };
  material.customProgramCacheKey = () => 'fronts first';
  return material;
}
