/** Shares what is copied with the other pages of this address in the same browser. */
import type {Store} from './store.js';

/** @param channel  connects the pages */
export function shareClipboard(store: Store, channel: BroadcastChannel): void {
  let received: Store['clipboard'] = null;
  store.listen('clipboard', () => {
    if (store.clipboard !== received) channel.postMessage(store.clipboard);
  });
  channel.addEventListener('message', ({data}) => {
    received = data;
    store.setClipboard(data);
  });
}
