/** A group of controls, which a lesson or a link can hide. */
import type { ComponentChildren } from "preact";
import type { Control } from "../page-state";
import type { Session } from "../session/session";

export function Group(props: {
  session: Session;
  /** Hidden if all of these are. */
  controls: Control[];
  title: string;
  folded?: boolean;
  children: ComponentChildren;
}) {
  const { hidden } = props.session;
  if (props.controls.every((control) => hidden.value.includes(control))) return null;
  return (
    <details class="group" open={!props.folded}>
      <summary>
        <h3>{props.title}</h3>
      </summary>
      {props.children}
    </details>
  );
}

/** A button that does something which may be refused; what was wrong is then shown. */
export function Act(props: {
  session: Session;
  work: () => Promise<unknown>;
  disabled?: boolean;
  class?: string;
  children: ComponentChildren;
}) {
  const { session, work, disabled = false } = props;
  return (
    <button type="button" class={props.class} disabled={disabled} onClick={() => void session.attempt(work)}>
      {props.children}
    </button>
  );
}
