/** Which buttons of the mouse are down. */

/** Bits of `buttons` by number of `button` (Pointer Events, 5.1.1.2). */
const BITS = [1, 4, 2, 8, 16];

/**
 * Whether a button is still down. While another one is, its release comes as a `pointermove`, and the
 * `pointerup` is that of the last one.
 */
export const isDown = ({buttons}: {buttons: number}, button: number) => (buttons & BITS[button]) !== 0;
