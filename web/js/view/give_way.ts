/**
 * Slow pictures wait for what a hand does elsewhere on the page: where a processor draws, a menu would
 * else be seen behind the picture that is begun with it.
 */

/** Milliseconds from which on a picture is slow. */
const SLOW = 45;
/**
 * Milliseconds for which the next picture waits after a press and after a movement of the mouse: a hand
 * rests for 0.1 s on what it is about to press.
 */
const WAIT = {press: 200, move: 160};
/** Longest time between pictures, ms: moving models must not appear to stop. */
const STALEST = 400;

export class GiveWay {
  #took = 0;
  #done = 0;
  #until = 0;

  /**
   * A hand is at work beside the view.
   * @param now  ms
   */
  hand(hand: 'press'|'move', now: number) {
    if (this.#took > SLOW) this.#until = Math.max(this.#until, now + WAIT[hand]);
  }

  /**
   * A picture is finished.
   * @param took  ms
   * @param now  ms
   */
  pictured(took: number, now: number) {
    this.#took = took;
    this.#done = now;
  }

  /**
   * Whether the next picture waits.
   * @param now  ms
   */
  waits(now: number) {
    return now < this.#until && now - this.#done < STALEST;
  }
}
