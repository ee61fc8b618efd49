/** How keys and values of a link are written, and read again. */
import type { Json } from "./engine/contract";

export interface LinkFault {
  key: string;
  problem: string;
}

export type Fail = (key: string, problem: string) => void;

type Tree = Record<string, Json>;

const MOST_CHARACTERS = 20_000;
const NAME = /^[A-Za-z_][A-Za-z0-9_]*$/;

// Trees of values: options, config, brain.

export function flat(path: string, value: Json): [string, string][] {
  if (isTree(value)) {
    const names = Object.keys(value);
    if (names.length > 0 && names.every((name) => NAME.test(name))) {
      return names.flatMap((name) => flat(`${path}.${name}`, value[name]!));
    }
  }
  return [[path, typeof value === "string" && !isJson(value) ? value : JSON.stringify(value)]];
}

export function readTree(root: string, entries: Map<string, string>, base: Tree, fail: Fail): Tree {
  const paths = [...entries.keys()].filter((key) => key === root || key.startsWith(`${root}.`));
  let tree: Json = paths.length === 0 ? base : {};
  for (const path of paths) {
    const text = entries.get(path)!;
    entries.delete(path);
    const value: Json = isJson(text) ? JSON.parse(text) : text;
    const names = path.split(".").slice(1);
    if (names.some((name) => !NAME.test(name) || name === "__proto__")) fail(path, "no such key");
    else if (names.length > 0) {
      if (!put(tree as Tree, names, value)) fail(path, "it is given twice");
    } else if (isTree(value) && paths.length === 1) tree = value;
    else fail(path, "its parts are written one by one, as in config.a.b=1");
  }
  return tree as Tree;
}

function put(tree: Tree, names: string[], value: Json): boolean {
  const [name, ...rest] = names as [string, ...string[]];
  const inside = Object.hasOwn(tree, name) ? tree[name] : undefined;
  if (rest.length === 0) {
    if (inside !== undefined) return false;
    tree[name] = value;
    return true;
  }
  if (inside !== undefined && !isTree(inside)) return false;
  if (inside === undefined) tree[name] = {};
  return put(tree[name] as Tree, rest, value);
}

function isTree(value: Json): value is Tree {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function isJson(text: string): boolean {
  try {
    JSON.parse(text);
    return true;
  } catch {
    return false;
  }
}

/** Whether two values of JSON are equal, whatever the order of their keys. */
export function same(a: unknown, b: unknown): boolean {
  if (Object.is(a, b)) return true;
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  if (Array.isArray(a) !== Array.isArray(b)) return false;
  const names = Object.keys(a);
  return (
    names.length === Object.keys(b).length &&
    names.every((name) => Object.hasOwn(b, name) && same((a as Tree)[name], (b as Tree)[name]))
  );
}

// Characters: what an address may hold after "#" stays as it is, so that a link can be read.

export function written(text: string): string {
  return encodeURIComponent(text).replace(/%(2F|3A|2C|40|24|3B|2B|3D|3F)/g, decodeURIComponent);
}

export function split(hash: string): { entries: Map<string, string>; faults: LinkFault[] } {
  const entries = new Map<string, string>();
  const faults: LinkFault[] = [];
  if (hash.length > MOST_CHARACTERS) {
    return { entries, faults: [{ key: "link", problem: `it has more than ${MOST_CHARACTERS} characters` }] };
  }
  for (const part of hash.replace(/^#/, "").split("&").filter(Boolean)) {
    const at = part.indexOf("=");
    const key = plain(at < 0 ? part : part.slice(0, at));
    const value = at < 0 ? null : plain(part.slice(at + 1));
    if (key === null || value === null)
      faults.push({ key: key ?? part, problem: "it is not written as key=value" });
    else if (entries.has(key)) faults.push({ key, problem: "it is given twice" });
    else entries.set(key, value);
  }
  return { entries, faults };
}

function plain(text: string): string | null {
  try {
    return decodeURIComponent(text);
  } catch {
    return null;
  }
}
