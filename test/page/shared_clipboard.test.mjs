import assert from 'node:assert/strict';
import {test} from 'node:test';
import {shareClipboard} from '../../web/js/shared_clipboard.js';
import {Store} from '../../web/js/store.js';

const COPIED = {text: '<sdf/>', items: []};

test('what one page copies can be pasted in another, and is sent once', async () => {
  const channels = [0, 1, 2].map(() => new BroadcastChannel('shared_clipboard.test'));
  const [one, other, last] = channels;
  const stores = [new Store(), new Store()];
  try {
    shareClipboard(stores[0], one);
    shareClipboard(stores[1], other);
    const messages = [];
    const ended = new Promise((done) => last.addEventListener('message', ({data}) => {
      messages.push(data);
      if (data === null) done();
    }));
    const received = new Promise((done) => stores[1].addEventListener('clipboard', done));
    stores[0].setClipboard(COPIED);
    await received;
    assert.deepEqual(stores[1].clipboard, COPIED);
    stores[1].setClipboard(null);
    await ended;
    assert.deepEqual(messages, [COPIED, null]);
  } finally {
    for (const channel of channels) channel.close();
  }
});
