/**
 * An EventTarget whose events carry details of known types.
 *
 * @template {object} Details  the type of each event's detail by the event's name
 */
export class Emitter extends EventTarget {
  /**
   * Listens to an event.
   * @template {keyof Details & string} T
   * @param {T} type
   * @param {(event: CustomEvent<Details[T]>) => void} listener
   * @returns {() => void} stops listening
   */
  listen(type, listener) {
    const heard = /** @type {EventListener} */ (/** @type {unknown} */ (listener));
    this.addEventListener(type, heard);
    return () => this.removeEventListener(type, heard);
  }

  /**
   * Notifies the listeners of an event.
   * @template {keyof Details & string} T
   * @param {T} type
   * @param {Details[T]} [detail]
   */
  emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, {detail}));
  }
}
