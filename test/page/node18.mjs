/** What browsers and newer Node.js have of their own, and Node.js 18 has not. */

globalThis.CustomEvent ??= class CustomEvent extends Event {
  constructor(type, options = {}) {
    super(type, options);
    this.detail = options.detail ?? null;
  }
};
