import { render } from "preact";
import { startEngine } from "./engine/client";
import { keepAddress } from "./session/navigation";
import { Session } from "./session/session";
import { App } from "./shell/app";
import { setTheme, theme } from "./shell/theme";
import "./style/theme.css";
import "./style/page.css";

const place = document.getElementById("app")!;

async function main(): Promise<void> {
  setTheme(theme.value);
  const session = await Session.start(startEngine(), location.hash);
  keepAddress(session);
  place.replaceChildren();
  render(<App session={session} />, place);
  performance.mark("interactive");
  if (import.meta.env.PROD) await navigator.serviceWorker?.register("sw.js");
}

main().catch((error: unknown) => {
  const text = document.createElement("p");
  text.className = "fault";
  text.setAttribute("role", "alert");
  text.textContent = `The lab could not start: ${error instanceof Error ? error.message : String(error)}`;
  place.prepend(text);
});
