/**
 * Keeps the built page for use without a network. A new version waits until all tabs of the old one are closed,
 * so that no tab mixes files of two versions.
 */
declare const self: ServiceWorkerGlobalScope;
/** Names of the built files and a hash of them; the build puts them in. */
declare const __FILES__: string[];
declare const __VERSION__: string;

// Two copies of the lab on one host have caches of their own.
const PREFIX = `gym-babble-lab ${self.registration.scope} `;
const CACHE = PREFIX + __VERSION__;

self.addEventListener("install", (event) => {
  event.waitUntil(caches.open(CACHE).then((cache) => cache.addAll(["./", ...__FILES__])));
});

self.addEventListener("activate", (event) => {
  event.waitUntil(removeOldCaches().then(() => self.clients.claim()));
});

self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || !event.request.url.startsWith(self.registration.scope)) return;
  event.respondWith(cached(event.request));
});

async function removeOldCaches(): Promise<void> {
  const names = await caches.keys();
  const old = names.filter((name) => name.startsWith(PREFIX) && name !== CACHE);
  await Promise.all(old.map((name) => caches.delete(name)));
}

async function cached(request: Request): Promise<Response> {
  const cache = await caches.open(CACHE);
  return (await cache.match(request, { ignoreSearch: true })) ?? fetch(request);
}

export {};
