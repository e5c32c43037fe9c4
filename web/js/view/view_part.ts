/** The base class of parts of the view: it has the store, the stage and all else that they share. */
import {withParts} from '../parts.js';
import type {ViewParts} from './view.js';

export const ViewPart = withParts<ViewParts>();
