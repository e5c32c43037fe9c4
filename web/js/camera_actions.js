/** Where the camera looks from: sides, flights, bookmarks, links, following, projection. */
import {remembered} from './panels/dom.js';
import {linkOf} from './view_link.js';
/** @import {ActionParts} from './actions.js' */
/** @import {CameraChoices} from './store.js' */

/** @typedef {{name: string, view: import('./camera_math.js').View}} Bookmark  a camera to come back to */

/** @param {ActionParts} parts */
export function cameraActions({store, note, view}) {
  const bookmarksKey = () => `bookmarks.${store.history.file || store.document?.name || ''}`;

  const camera = {
    /** @param {'top'|'bottom'|'front'|'back'|'left'|'right'|'home'} side */
    viewFrom: (side) => view()?.viewFrom(side),
    resetView: () => view()?.viewFrom('home'),
    moveTo: (name = store.selection.at(-1)) => name && view()?.moveTo(name),
    /** The whole selection; without one all models. */
    frameSelection: () => view()?.frame(store.selection),
    frameAll: () => view()?.frame(),
    /** The address that opens this page with this camera and selection, to the clipboard. */
    async copyLink() {
      const link = camera.viewLink();
      if (!link) return;
      try {
        await navigator.clipboard.writeText(link);
        note('Copied the link to this view.');
      } catch {
        // Without permission it stands in the address bar.
        history.replaceState(null, '', link);
        note('The link to this view is in the address bar.');
      }
    },
    viewLink() {
      const shown = view();
      return shown && `${location.href.split('#')[0]}${linkOf(shown.camera, store.selection)}`;
    },
    /** Cameras that the user keeps, of this world. @returns {Bookmark[]} */
    bookmarks: () => remembered.get(bookmarksKey(), []),
    addBookmark() {
      const shown = view();
      if (!shown) return;
      const kept = camera.bookmarks();
      const numbers = kept.map(({name}) => Number(/^View (\d+)$/.exec(name)?.[1] ?? 0));
      const name = `View ${Math.max(0, ...numbers) + 1}`;
      remembered.set(bookmarksKey(), [...kept, {name, view: shown.camera}]);
      note(`Kept this camera as ${name}: Camera menu.`);
    },
    /** @param {number} at */
    goToBookmark(at) {
      const bookmark = camera.bookmarks()[at];
      if (bookmark) view()?.flyTo(bookmark.view);
    },
    clearBookmarks: () => remembered.set(bookmarksKey(), []),
    /**
     * What the models of the world cover of the ground, but for planes and one of them.
     * @param {string} [without]
     */
    footprints: (without) => (store.document?.models ?? []).flatMap(({name}) => {
      const outline = name === without ? null : view()?.footprint(name);
      return outline ? [{name, outline}] : [];
    }),
    /** @param {string|null} name  null ends it @returns {void} */
    follow(name = store.selection.at(-1) ?? null) {
      if (name) store.setMode('select');
      store.setCamera({following: name});
    },
    /** @param {CameraChoices['projection']} projection */
    setProjection(projection) {
      if (projection === 'orthographic' && store.camera.projection !== projection) view()?.keepScale();
      store.setCamera({projection});
    },
    /** @param {CameraChoices['controller']} controller */
    setController: (controller) => store.setCamera({controller}),
    perspective: () => camera.setProjection('perspective'),
    orthographic: () => camera.setProjection('orthographic'),
    orbitControl: () => store.setCamera({controller: 'orbit'}),
    fpsControl: () => store.setCamera({controller: 'fps'}),
  };
  return camera;
}
