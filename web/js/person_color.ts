import type {Person} from './protocol.js';

const COLORS = ['#4f9cf0', '#4bc07a', '#e06c9f', '#b58cf0', '#d9a13a', '#3fc1c9', '#f07860'];

/** The colour of a user's marks. */
export const colorOf = ({number}: Person) => COLORS[number % COLORS.length];
