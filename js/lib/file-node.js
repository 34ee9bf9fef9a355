// The bytes of a file, in Node.
import { readFile } from "node:fs/promises";

export const bytesOf = (address) => readFile(address);
