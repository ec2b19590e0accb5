// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The BIDS validator of the schema, as npm's bids-validator ships it for Deno, run by Node:
//   npm pack bids-validator && tar xzf bids-validator-*.tgz
//   node bids_validator.mjs package DATASET   prints a line an error; exit code 1 if there are any
import fs from "node:fs";
import path from "node:path";
import { Readable } from "node:stream";
import { pathToFileURL } from "node:url";

const [validator, dataset] = process.argv.slice(2);
globalThis.Deno = {
  args: [path.resolve(dataset), "--json"],
  cwd: () => process.cwd(),
  build: { os: process.platform },
  env: { get: (name) => process.env[name] },
  stdout: { isTerminal: () => false },
  permissions: {
    query: async () => ({ state: "granted" }),
    request: async () => ({ state: "granted" }),
  },
  SeekMode: { Start: 0 },
  mainModule: "file:///",
  inspect: (x) => JSON.stringify(x),
  statSync: (file) => fs.statSync(file),
  lstatSync: (file) => fs.lstatSync(file),
  readTextFileSync: (file) => fs.readFileSync(file, "utf8"),
  async *readDir(folder) {
    for (const entry of fs.readdirSync(folder, { withFileTypes: true })) {
      yield {
        name: entry.name,
        isFile: entry.isFile(),
        isSymlink: entry.isSymbolicLink(),
        isDirectory: entry.isDirectory(),
      };
    }
  },
  openSync(file) {
    const handle = fs.openSync(file, "r");
    let at = 0;
    return {
      get readable() {
        return Readable.toWeb(fs.createReadStream(file));
      },
      seek: async (offset) => (at = offset),
      read: async (buffer) => fs.readSync(handle, buffer, 0, buffer.length, at),
      close: () => fs.closeSync(handle),
    };
  },
};
const entry = pathToFileURL(path.resolve(validator, "dist/validator/main.js"));
const print = console.log;
console.log = () => {};  // main() prints every issue as one line of JSON
const { issues } = await (await import(entry)).main();
const errors = issues.issues.filter((issue) => issue.severity === "error");
for (const e of errors) print([e.code, e.subCode, e.location, e.issueMessage].filter(Boolean).join(" "));
print(`${errors.length} errors`);
process.exit(errors.length > 0 ? 1 : 0);
