/** Sim time between two messages that tell it: it goes on at the rate that was told last. */

/** Milliseconds after which a silent simulator is taken to stand still. */
const SILENCE = 1000;
/** Seconds by which a guess may have been ahead: then time waits, it does not go back. */
const AHEAD = 0.1;

export class SimClock {
  #time = 0;
  #rate = 0;
  #told = 0;
  #shown = 0;

  /**
   * @param time  sim time, s
   * @param rate  sim seconds in a second, 0: it stands
   * @param now  ms
   */
  tell(time: number, rate: number, now: number) {
    this.#time = time;
    this.#rate = rate;
    this.#told = now;
  }

  /**
   * Sim time, s.
   * @param now  ms
   */
  at(now: number) {
    const passed = Math.min(Math.max(now - this.#told, 0), SILENCE) / 1000;
    const time = this.#time + passed * this.#rate;
    const ahead = this.#shown - time;
    if (this.#rate <= 0 || ahead <= 0 || ahead > AHEAD) this.#shown = time;
    return this.#shown;
  }

  /**
   * Whether time goes on.
   * @param now  ms
   */
  runs(now: number) {
    return this.#rate !== 0 && now - this.#told < SILENCE;
  }
}
