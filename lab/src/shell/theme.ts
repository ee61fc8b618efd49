/** Light or dark, as the system says or as the user chose. */
import { signal } from "@preact/signals";

export type Theme = "auto" | "light" | "dark";

const STORE = "gym-babble-lab-theme";
const system = matchMedia("(prefers-color-scheme: dark)");

export const theme = signal<Theme>(stored());

export function setTheme(next: Theme): void {
  theme.value = next;
  if (next === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = next;
  try {
    localStorage.setItem(STORE, next);
  } catch {
    // A browser that keeps nothing forgets the choice.
  }
}

export function isDark(): boolean {
  return theme.value === "dark" || (theme.value === "auto" && system.matches);
}

/** Calls back when it becomes dark or light; gives back what ends that. */
export function onThemeChange(callback: (dark: boolean) => void): () => void {
  const changed = () => callback(isDark());
  system.addEventListener("change", changed);
  const unsubscribe = theme.subscribe(changed);
  return () => {
    system.removeEventListener("change", changed);
    unsubscribe();
  };
}

function stored(): Theme {
  try {
    const text = localStorage.getItem(STORE);
    return text === "light" || text === "dark" ? text : "auto";
  } catch {
    return "auto";
  }
}
