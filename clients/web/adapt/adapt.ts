/** The page that makes a head from photos. */

import { Editor } from "./editor";

const address = new URL("/adapt/ws", location.href);
address.protocol = address.protocol.replace("http", "ws");
new Editor(address.href, new URLSearchParams(location.hash.slice(1)).get("token"));
