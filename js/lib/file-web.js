// Browsers have no files: bundlers take this in place of file-node.js.
export function bytesOf(address) {
  throw new Error(`${address}: a browser reads no files; give an address of a server`);
}
