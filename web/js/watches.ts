/** What this page wants to be told of: several parts ask, the simulator hears one list. */
import type {Connection} from './connection.js';

export class Watches {
  #connection;
  #counts = new Map();
  #sending = false;

  constructor(connection: Connection) {
    this.#connection = connection;
    connection.listen('open', () => {
      if (this.#counts.size) this.#tell();
    });
  }

  /** The topics asked for now. */
  get topics(): string[] {
    return [...this.#counts.keys()];
  }

  /**
   * Asks for a topic: `contacts`, `joints:<model>`, `plot:<variable>`.
   * @returns says that it is no longer wanted
   */
  add(topic: string): () => void {
    this.#counts.set(topic, (this.#counts.get(topic) ?? 0) + 1);
    this.#tell();
    let wanted = true;
    return () => {
      if (!wanted) return;
      wanted = false;
      const left = this.#counts.get(topic) - 1;
      if (left) this.#counts.set(topic, left);
      else this.#counts.delete(topic);
      this.#tell();
    };
  }

  /** Several changes in a row are one request. */
  #tell() {
    if (this.#sending) return;
    this.#sending = true;
    queueMicrotask(() => {
      this.#sending = false;
      // While the line is down nothing is lost: the whole list is sent when it is back.
      if (this.#connection.connected) {
        this.#connection.request('watch', {topics: this.topics}).catch(() => this.#refused());
      }
    });
  }

  #refused() {
    // The line was lost meanwhile; 'open' sends the list again.
  }
}
