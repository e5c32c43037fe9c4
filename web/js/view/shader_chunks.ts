/** What the view's shaders do otherwise than three's. To be changed before the first of them is made. */
import {ShaderChunk} from 'three';

function replace(chunk: keyof typeof ShaderChunk, part: string|RegExp, other: string) {
  ShaderChunk[chunk] = ShaderChunk[chunk].replace(part, other);
}

const NO_TONE_MAPPING = 'vec3 CustomToneMapping( vec3 color ) { return color; }';
/**
 * Bright lights are pressed together above three quarters, as in Khronos' neutral tone mapping; what is
 * darker keeps the colour that its file says.
 */
const HIGHLIGHTS = `vec3 CustomToneMapping( vec3 color ) {
  float peak = max( color.r, max( color.g, color.b ) );
  if ( peak < 0.76 ) return color;
  float pressed = 1.0 - 0.0576 / ( peak - 0.52 );
  return mix( color * pressed / peak, vec3( pressed ), 1.0 - 1.0 / ( 0.15 * ( peak - pressed ) + 1.0 ) );
}`;

export function keepHighlights() {
  replace('tonemapping_pars_fragment', NO_TONE_MAPPING, HIGHLIGHTS);
}

const SQUARED_FOG = 'exp( - fogDensity * fogDensity * vFogDepth * vFogDepth )';
const EITHER_FOG = `( fogDensity < 0.0 ? exp( fogDensity * vFogDepth ) : ${SQUARED_FOG} )`;

const SMOOTH_FOG = 'smoothstep( fogNear, fogFar, vFogDepth )';
const LINEAR_FOG = '1.0 - clamp( ( fogFar - vFogDepth ) / max( fogFar - fogNear, 1e-6 ), 0.0, 1.0 )';

/**
 * Changes three's fog to Gazebo's, as cameras have it. Fog becomes linear. A FogExp2 of negative
 * density becomes `exp`, which three lacks: its exponent is not squared.
 */
export function gazeboFog() {
  replace('fog_fragment', SQUARED_FOG, EITHER_FOG);
  replace('fog_fragment', SMOOTH_FOG, LINEAR_FOG);
}

/** three's softening of shadows: five samples at places turned by noise, from sines and cosines. */
const TURNED_SAMPLES = /vec2 texelSize = vec2\( 1\.0 \) \/ shadowMapSize;[^}]*?\) \* 0\.2;/;
/**
 * One sample between four texels without a radius, else four of them, which reach four texels far.
 * A loop is left after its last turn; both branches of a condition would be computed.
 */
const PLAIN_SAMPLES = `shadow = 0.0;
  int samples = shadowRadius > 0.0 ? 4 : 1;
  for ( int at = 0; at < samples; at ++ ) {
    vec2 corner = vec2( float( at & 1 ), float( at >> 1 ) ) * 2.0 - 1.0;
    shadow += texture( shadowMap, vec3( shadowCoord.xy + corner * min( shadowRadius, 1.0 ) / shadowMapSize, shadowCoord.z ) );
  }
  shadow /= float( samples );`;

const POWER = /vec4 sRGBTransferOETF\([^}]*\}/;
/** The same curve from square roots, within 1/255. */
const ROOTS = `vec4 sRGBTransferOETF( in vec4 value ) {
  vec3 color = max( value.rgb, vec3( 0.0 ) );
  vec3 root = sqrt( color );
  vec3 fourth = sqrt( root );
  vec3 curve = 0.662002687 * root + 0.684122060 * fourth - 0.323583601 * sqrt( fourth ) - 0.0225411470 * color;
  return vec4( max( curve, min( 12.92 * color, vec3( 0.04 ) ) ), value.a );
}`;

/** Spares a processor that draws what a graphics card has units for. */
export function spareProcessor() {
  replace('shadowmap_pars_fragment', TURNED_SAMPLES, PLAIN_SAMPLES);
  replace('colorspace_pars_fragment', POWER, ROOTS);
}
