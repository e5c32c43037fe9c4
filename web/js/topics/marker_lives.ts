/** How long markers are shown. Pure. */

/** Seconds by which a guess of sim time may be behind one before. */
const BEHIND = 1;

/** From when on something is shown, sim time, and how long, s; 0: for ever. */
export type Life = {from: number, lifetime: number};

/**
 * Returns whether a lifetime is over, or sim time was reset.
 * @param now  sim time, s
 */
export const isOver = ({from, lifetime}: Life, now: number) =>
  lifetime > 0 && (now >= from + lifetime || now < from - BEHIND);
