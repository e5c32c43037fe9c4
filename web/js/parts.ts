/** Objects that have other parts of the page as fields. */

/** A base class that has the properties of what its constructor gets. */
export const withParts = <Parts extends object>() => class {
  constructor(parts: Parts) {
    Object.assign(this, parts);
  }
} as new (parts: Parts) => Readonly<Parts>;
