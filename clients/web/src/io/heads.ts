/** Head files over HTTP, each fetched and read once a page; blobs, which pages make and drop, are not kept. */

import { readAnyHead } from "../head/foreign";
import { HeadError, type Head } from "../head/model";

const heads = new Map<string, Promise<Head>>();

/** The head at `url`. Rejects with HeadError; the next call tries again then. */
export function loadHead(url: string): Promise<Head> {
  const known = heads.get(url);
  if (known) return known;
  const head = fetchHead(url);
  if (url.startsWith("blob:")) return head;
  heads.set(url, head);
  head.catch(() => heads.delete(url));
  return head;
}

async function fetchHead(url: string): Promise<Head> {
  let response: Response;
  try {
    response = await fetch(url);
  } catch {
    throw new HeadError(`${url} cannot be reached`);
  }
  if (!response.ok) throw new HeadError(`${url}: HTTP ${response.status}`);
  const name = url.split(/[?#]/)[0].split("/").at(-1)!.replace(/\.\w+$/, "");
  const data = new Uint8Array(await response.arrayBuffer());
  try {
    const { head, warnings } = readAnyHead(data, name);
    for (const warning of warnings) console.warn(`fap-head: ${warning}`);
    return head;
  } catch (e) {
    throw e instanceof HeadError ? new HeadError(`${url}: ${e.message}`) : e;
  }
}
