/** The script that pages embed: defines `<fap-head>`. */

import { FapHead } from "./element";

if (!customElements.get("fap-head")) customElements.define("fap-head", FapHead);

export { FapHead };
export { HeadFault, OwnTurn, Turn, type SpeakOptions, type TurnEnd } from "./client/turn";
export type { Stats } from "./presenter";

declare global {
  interface HTMLElementTagNameMap {
    "fap-head": FapHead;
  }
}
