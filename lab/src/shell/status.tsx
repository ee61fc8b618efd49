/** What happens, in words; how far long work is, and a way to stop it. */
import { useEffect, useState } from "preact/hooks";
import type { Session } from "../session/session";
import type { Job } from "../session/work";

/** Work that takes longer has a bar with the time left [s]. */
const LONG = 2;
/** A screen reader shall not be told more often [ms]. */
const TOLD_EVERY = 2000;

export function Status({ session }: { session: Session }) {
  const job = session.job.value;
  return (
    <footer class="status">
      {job && <Progress job={job} stop={() => session.stop()} />}
      <Told text={session.said.value} />
    </footer>
  );
}

function Progress({ job, stop }: { job: Job; stop: () => void }) {
  const { label, done, total, seconds, secondsLeft } = job;
  const takes = secondsLeft === null ? seconds : seconds + secondsLeft;
  const text =
    total === null
      ? `${label}${done > 0 ? `: ${count(done)}` : ""}`
      : `${label}: ${count(done)} of ${count(total)}`;
  return (
    <div class="row">
      <span>{text}</span>
      {total !== null && takes > LONG && <progress value={done} max={total} aria-label={label} />}
      {job.bar && total === null && <progress aria-label={label} />}
      {secondsLeft !== null && takes > LONG && <span>{timeLeft(secondsLeft)} left</span>}
      <button type="button" onClick={stop}>
        Stop
      </button>
    </div>
  );
}

/** Text that changes at once for the eye, and every two seconds for the ear. */
function Told({ text }: { text: string }) {
  const [told, setTold] = useState("");
  const [last, setLast] = useState(0);
  useEffect(() => {
    const wait = Math.max(0, last + TOLD_EVERY - performance.now());
    const timer = setTimeout(() => {
      setTold(text);
      setLast(performance.now());
    }, wait);
    return () => clearTimeout(timer);
  }, [text, last]);
  return (
    <>
      <p aria-hidden="true">{text}</p>
      <p class="hidden" role="status">
        {told}
      </p>
    </>
  );
}

const count = (n: number) => n.toLocaleString("en");

function timeLeft(seconds: number): string {
  if (seconds < 60) return `${Math.ceil(seconds)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}
