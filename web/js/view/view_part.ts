/** The base class of parts of the view. */
import type {ViewParts} from './view.js';

/** Has the parts that all share as fields: the store, the stage and so on. */
export const ViewPart = class {
  constructor(parts: ViewParts) {
    Object.assign(this, parts);
  }
} as new (parts: ViewParts) => Readonly<ViewParts>;
