/** Keeps the address of the page and its state the same; the browser's back button leads back. */
import { effect } from "@preact/signals";
import type { Session } from "./session";

export function keepAddress(session: Session): void {
  let following = false;

  /** Goes where the browser went; it may go on while the engine still works. */
  const follow = async () => {
    if (following) return;
    following = true;
    for (let hash = ""; location.hash !== hash && here() !== session.address(); ) {
      hash = location.hash;
      await session.attempt(() => session.follow(hash));
    }
    following = false;
    write(session.address(), "replaceState");
  };
  addEventListener("popstate", () => void follow());

  // What was wrong in the first link is not worth a way back.
  write(session.address(), "replaceState");
  effect(() => {
    const address = session.address();
    if (!following) write(address, "pushState");
  });
}

const here = () => location.hash.slice(1);

function write(address: string, how: "pushState" | "replaceState"): void {
  if (here() === address) return;
  history[how](null, "", `${location.pathname}${location.search}${address && "#"}${address}`);
}
