/**
 * What the simulator has to say: a short card for each issue, and a list that keeps them all, each
 * with its file and line.
 */
import {RequestError} from '../connection.js';
import {fill, h, rememberedInTab, textButton} from '../ui/dom.js';
import {faultText} from '../ui/dialog.js';
import {closeButton, icon, iconButton} from '../ui/icons.js';
import type {Issue} from '../connection.js';

const SECONDS = {error: 12, warning: 8, note: 4};
const KEPT = 500;
const CARDS = 4;
const SEEN = 'issues-seen';

export class Notices {
  element;
  entries: {issue: Issue, count: number, at: Date}[] = [];
  unseen = 0;
  badge = h('span', {class: 'badge', hidden: true});
  /** Unix time in s of the last issue that this tab showed before its page was loaded. */
  #seenBefore = rememberedInTab.get(SEEN, 0);
  button = iconButton('messages', 'Messages', () => this.#toggle(), 16, {class: 'plain notices-button', 'aria-expanded': 'false'});

  /** @param element  where the cards appear */
  constructor(element: HTMLElement) {
    this.element = element;
    this.button.append(this.badge);
    this.#list.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      this.#toggle();
    });
    document.body.append(this.#list);
  }

  #list = h('div', {
    class: 'notice-list',
    hidden: true,
    role: 'dialog',
    'aria-label': 'All messages',
  });

  /** Shows an issue; one that this tab has shown before is only listed. */
  add(issue: Issue) {
    const {time} = issue;
    if (time) rememberedInTab.set(SEEN, Math.max(time, rememberedInTab.get(SEEN, 0)));
    const isSeen = Boolean(time && time <= this.#seenBefore);
    const last = this.entries[0];
    const again = last && last.issue.message === issue.message && last.issue.line === issue.line;
    if (again) last.count += 1;
    else this.entries.unshift({issue, count: 1, at: time ? new Date(1000 * time) : new Date()});
    this.entries.length = Math.min(this.entries.length, KEPT);
    if (!this.#list.hidden) this.#showList();
    else if (issue.severity !== 'note' && !isSeen) this.#markUnseen(this.unseen + 1);
    if (!isSeen && (!again || !this.#renew())) this.#card(issue);
  }

  /** A word in passing: a path that was saved, an action that makes no sense now. */
  say(message: string) {
    this.add({severity: 'note', code: 'editor', message});
  }

  /** What came back of a refused request. */
  fault(fault: unknown) {
    if (fault instanceof RequestError) fault.issues.forEach((issue) => this.add(issue));
    else this.add({severity: 'error', code: 'editor', message: faultText(fault)});
  }

  #markUnseen(count: number) {
    this.unseen = count;
    this.badge.hidden = count === 0;
    this.badge.textContent = count > 99 ? '99+' : String(count);
  }

  /** Lets the newest card stay on; false where it has gone. */
  #renew: () => boolean = () => false;

  #card(issue: Issue) {
    const severity = issue.severity ?? 'error';
    const close = () => { card.remove(); };
    const card = h(
      'div',
      {class: `notice ${severity}`},
      icon(glyph(severity), 16),
      body(issue),
      closeButton('Dismiss', close),
    );
    let timer = setTimeout(close, SECONDS[severity] * 1000);
    card.addEventListener('pointerenter', () => clearTimeout(timer));
    card.addEventListener('pointerleave', () => {
      timer = setTimeout(close, 3000);
    });
    this.#renew = () => {
      clearTimeout(timer);
      timer = setTimeout(close, SECONDS[severity] * 1000);
      return card.isConnected;
    };
    this.element.append(card);
    while (this.element.childElementCount > CARDS) this.element.firstElementChild?.remove();
  }

  #toggle() {
    const show = this.#list.hidden;
    this.#list.hidden = !show;
    this.button.setAttribute('aria-expanded', String(show));
    if (show) {
      this.#markUnseen(0);
      this.#showList();
      this.#list.querySelector('button')?.focus();
    } else this.button.focus();
  }

  #showList() {
    fill(
      this.#list,
      h(
        'div',
        {class: 'notice-head'},
        h('h2', {text: 'Messages'}),
        textButton('Clear', () => {
          this.entries = [];
          this.#showList();
        }),
        closeButton('Close', () => this.#toggle(), 14),
      ),
      this.entries.length
        ? h(
            'ol',
            {},
            ...this.entries.map(({issue, count, at}) =>
              h(
                'li',
                {class: issue.severity ?? 'error'},
                icon(glyph(issue.severity ?? 'error'), 15),
                body(issue),
                h('span', {
                  class: 'soft',
                  text: `${count > 1 ? `${count}× ` : ''}${at.toLocaleTimeString()}`,
                }),
              ),
            ),
          )
        : h('p', {class: 'empty', text: 'No messages'}),
    );
  }
}

function glyph(severity: string) {
  return {error: 'error', warning: 'warning'}[severity] ?? 'info';
}

function body(issue: Issue) {
  const place = issue.file ? `${issue.file}${issue.line ? `:${issue.line}` : ''}` : '';
  return h(
    'div',
    {class: 'notice-body'},
    h('div', {text: issue.message}),
    issue.hint && h('div', {class: 'soft', text: issue.hint}),
    place && h('code', {text: place}),
    issue.xpath && h('code', {class: 'soft', text: issue.xpath}),
  );
}
