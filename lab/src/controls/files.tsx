/** Agents as files, Python for the same agent, and the record to hand in. */
import { useRef, useState } from "preact/hooks";
import type { Session } from "../session/session";
import { copyText } from "../shell/copy";
import { Act, Group } from "./group";

export function FileControls({ session }: { session: Session }) {
  const agent = session.shownAgent.value;
  const learns = session.state.value.agents[agent]?.learns ?? false;
  return (
    <Group session={session} controls={["files"]} title="Take it with you" folded>
      <div class="row">
        <label>
          your name{" "}
          <input
            type="text"
            maxLength={100}
            value={session.name.value}
            onInput={(event) => {
              session.name.value = event.currentTarget.value;
            }}
          />
        </label>
        <Act session={session} disabled={session.name.value.trim() === ""} work={() => handIn(session)}>
          Download what you did, to hand in
        </Act>
      </div>
      <p class="hint">
        The record needs your name. It has what you did in one lesson: download it before you go on to
        another.
      </p>
      <div class="row">
        <Act session={session} disabled={!learns} work={() => saveAgent(session, agent)}>
          Save the agent
        </Act>
        <label class="file">
          Load an agent
          <input
            type="file"
            accept=".safetensors"
            onChange={(event) => {
              const file = event.currentTarget.files?.[0];
              if (file) {
                void session.attempt(async () =>
                  session.loadAgent(agent, new Uint8Array(await file.arrayBuffer())),
                );
              }
            }}
          />
        </label>
        <PythonButton session={session} agent={agent} />
      </div>
    </Group>
  );
}

async function handIn(session: Session): Promise<void> {
  const record = await session.record();
  const name = fileName(session.lesson.value?.id ?? "lab", session.name.value);
  download(new Blob([record], { type: "application/json" }), `${name}.json`);
  session.said.value = "What you did is downloaded as a file to hand in.";
}

async function saveAgent(session: Session, agent: number): Promise<void> {
  const bytes = await session.engine.saveAgent(agent);
  download(new Blob([new Uint8Array(bytes)]), `${fileName("agent", session.task.value)}.safetensors`);
}

function fileName(...parts: string[]): string {
  const words = parts.map((part) => part.replace(/[^\p{L}\p{N}]+/gu, "-")).filter(Boolean);
  return words.join("-").slice(0, 80);
}

function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function PythonButton({ session, agent }: { session: Session; agent: number }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [code, setCode] = useState("");
  const [said, setSaid] = useState("");
  const open = async () => {
    setCode(await session.engine.python(agent));
    setSaid("");
    dialog.current!.showModal();
  };
  return (
    <>
      <Act session={session} work={open}>
        Open in Python
      </Act>
      <dialog ref={dialog} aria-labelledby="python-title">
        <h2 id="python-title">The same in Python</h2>
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keyboard */}
        <pre tabIndex={0}>{code}</pre>
        <div class="row">
          <Act
            session={session}
            work={async () => setSaid((await copyText(code)) ? "Copied." : "Select the text and copy it.")}
          >
            Copy
          </Act>
          <button type="button" onClick={() => dialog.current!.close()}>
            Close
          </button>
          <span aria-live="polite">{said}</span>
        </div>
      </dialog>
    </>
  );
}
