/** Keeps the address of the page and its state the same; the browser's back button leads back. */
import { effect } from "@preact/signals";
import type { Session } from "./session";

export function keepAddress(session: Session): () => void {
  const followed = () => {
    if (location.hash.slice(1) !== session.address()) {
      void session.attempt(() => session.follow(location.hash));
    }
  };
  addEventListener("popstate", followed);
  let first = true;
  const stop = effect(() => {
    const address = session.address();
    if (location.hash.slice(1) !== address) {
      const url = `${location.pathname}${location.search}${address && "#"}${address}`;
      // What was wrong in the first link is not worth a way back.
      if (first) history.replaceState(null, "", url);
      else history.pushState(null, "", url);
    }
    first = false;
  });
  return () => {
    stop();
    removeEventListener("popstate", followed);
  };
}
