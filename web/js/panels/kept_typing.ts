/** The focus, and text that is not yet confirmed, in fields that are built again. */
import {elementsOf} from '../ui/dom.js';

type Place = {target: string, path: string, label: string};
type TextField = HTMLInputElement|HTMLTextAreaElement;
type Draft = {place: Place, input: TextField};

/**
 * `focus`: whether the field that had the focus gets it back; `confirm`: whether text is committed
 * whose field is not there any more, as when the focus leaves it.
 */
export type Restore = (how: {focus: boolean, confirm: boolean}) => void;

/**
 * Stores what the user types before the fields are replaced.
 * @returns gives the text to the same fields of what was built; null where nothing is typed and no
 * field has the focus
 */
export function keepTyping(body: HTMLElement): Restore|null {
  const active = inputsOf(body).find((one) => one === document.activeElement);
  const drafts: Draft[] = inputsOf(body).flatMap((input) => {
    if (!isText(input) || input.dataset.edited === undefined) return [];
    // Chromium sends `blur` to an element that is removed: nothing is confirmed by that.
    delete input.dataset.edited;
    return [{place: placeOf(input), input}];
  });
  if (!active && !drafts.length) return null;
  const caret = isText(active) && active.type.startsWith('text') && drafts.length
    ? [active.selectionStart, active.selectionEnd] as const : null;
  const focused = active && placeOf(active);
  return ({focus, confirm}) => {
    for (const {place, input: old} of drafts) {
      const input = inputAt(body, place);
      if (isText(input)) input.value = old.value;
      (input ?? old).dispatchEvent(new Event('input'));
      if (!input && confirm) old.dispatchEvent(new Event('blur'));
    }
    const input = focus && focused && (inputAt(body, focused) ?? inputAt(body, focused, false));
    if (!input) return;
    input.focus();
    if (caret && isText(input)) input.setSelectionRange(...caret);
  };
}

const isText = (element: HTMLElement|undefined|null): element is TextField =>
  element instanceof HTMLInputElement || element instanceof HTMLTextAreaElement;

const inputsOf = (body: HTMLElement) => elementsOf(body, '.field input, .field select, .field textarea');

function placeOf(input: HTMLElement): Place {
  const field = input.closest('.field');
  const {target = '', path = ''} = field instanceof HTMLElement ? field.dataset : {};
  return {target, path, label: input.getAttribute('aria-label') ?? ''};
}

/** @param exact  whether the target has to be the same: a renamed entity has another one */
const inputAt = (body: HTMLElement, place: Place, exact = true) => inputsOf(body).find((one) => {
  const {target, path, label} = placeOf(one);
  return path === place.path && label === place.label && (!exact || target === place.target);
});
