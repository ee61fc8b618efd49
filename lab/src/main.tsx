import { render } from "preact";
import "./style/theme.css";

render(<h1>gym-babble lab</h1>, document.getElementById("app")!);
