/**
 * An EventTarget whose events carry details of known types.
 * @template Details  the type of each event's detail by the event's name
 */
export class Emitter<Details extends object> extends EventTarget {
  /**
   * Listens to an event.
   * @returns stops listening
   */
  listen<T extends keyof Details & string>(type: T, listener: (event: CustomEvent<Details[T]>) =>
      void): () => void {
    const heard = listener as unknown as EventListener;
    this.addEventListener(type, heard);
    return () => this.removeEventListener(type, heard);
  }

  /** Notifies the listeners of an event. */
  emit<T extends keyof Details & string>(type: T, detail?: Details[T]) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
}
