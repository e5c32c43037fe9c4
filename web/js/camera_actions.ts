/** Where the camera looks from: sides, flights, bookmarks, links, following, projection. */
import {remembered} from './ui/dom.js';
import {linkOf} from './view_link.js';
import type {ActionParts} from './actions.js';
import type {CameraChoices} from './store.js';
import type {View} from './camera_math.js';

/** a camera to come back to */
type Bookmark = {name: string, view: View};

export function cameraActions({store, note, view}: ActionParts) {
  const bookmarksKey = () => `bookmarks.${store.history.file || store.document?.name || ''}`;

  const camera = {
    viewFrom: (side: 'top'|'bottom'|'front'|'back'|'left'|'right'|'home') => view()?.viewFrom(side),
    resetView: () => view()?.viewFrom('home'),
    moveTo: (name = store.selection.at(-1)) => name && view()?.moveTo(name),
    lookInto: (name: string) => view()?.rig.lookInto(name),
    /** The whole selection; without one all models. */
    frameSelection: () => view()?.rig.frame(store.selection),
    frameAll: () => view()?.rig.frame(),
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
    /** Cameras that the user keeps, of this world. */
    bookmarks: (): Bookmark[] => remembered.get(bookmarksKey(), []),
    addBookmark() {
      const shown = view();
      if (!shown) return;
      const kept = camera.bookmarks();
      const numbers = kept.map(({name}) => Number(/^View (\d+)$/.exec(name)?.[1] ?? 0));
      const name = `View ${Math.max(0, ...numbers) + 1}`;
      remembered.set(bookmarksKey(), [...kept, {name, view: shown.camera}]);
      note(`Kept this camera as ${name}: Camera menu.`);
    },
    goToBookmark(at: number) {
      const bookmark = camera.bookmarks()[at];
      if (bookmark) view()?.rig.fly(bookmark.view);
    },
    clearBookmarks: () => remembered.set(bookmarksKey(), []),
    /** What the models of the world cover of the ground, but for planes and one of them. */
    footprints: (without?: string) => (store.document?.models ?? []).flatMap(({name}) => {
      const outline = name === without ? null : view()?.footprint(name);
      return outline ? [{name, outline}] : [];
    }),
    /** @param name  null ends it */
    follow(name: string|null = store.selection.at(-1) ?? null): void {
      if (name) store.setMode('select');
      store.setCamera({following: name});
    },
    setProjection(projection: CameraChoices['projection']) {
      if (projection === 'orthographic' && store.camera.projection !== projection) view()?.rig.keepScale();
      store.setCamera({projection});
    },
    setController: (controller: CameraChoices['controller']) => store.setCamera({controller}),
    perspective: () => camera.setProjection('perspective'),
    orthographic: () => camera.setProjection('orthographic'),
    orbitControl: () => store.setCamera({controller: 'orbit'}),
    fpsControl: () => store.setCamera({controller: 'fps'}),
  };
  return camera;
}
