/** A camera and a selection as the part of an address behind `#`, and bookmarks of cameras. Pure. */
import type {View} from './camera_math.js';

const PLACES = 4;

const short = (value: number) => Number(value.toFixed(PLACES));

/** `#view=5,-5,2,2.36,-0.27&select=box,robot%3A%3Alink` */
export function linkOf({position, yaw, pitch}: View, selection: string[]) {
  const view = [...position, yaw, pitch].map(short).join(',');
  const names = selection.map(encodeURIComponent).join(',');
  return `#view=${view}${names && `&select=${names}`}`;
}

/** What such a part of an address says; null for what says nothing. */
export function readLink(hash: string): {view: View|null, selection: string[]}|null {
  const parts = new Map(hash.replace(/^#/, '').split('&').map((part) => {
    const [key, value = ''] = part.split('=');
    return [key, value];
  }));
  const numbers = (parts.get('view') ?? '').split(',').map(Number);
  const view = numbers.length === 5 && numbers.every(Number.isFinite)
    ? {position: numbers.slice(0, 3), yaw: numbers[3], pitch: numbers[4]} : null;
  const selection = (parts.get('select') ?? '').split(',').filter(Boolean).map(named);
  return view || selection.length ? {view, selection} : null;
}

function named(text: string) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;  // written by hand
  }
}
