// The types of the package: use.ts fits them, its wrong lines do not, and classes have the members that the module has.
//   node types.mjs PACKAGE_FOLDER USE_TS       without TypeScript (Debian: node-typescript) it is skipped
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, use] = process.argv.slice(2).map((path) => resolve(path));
const places = ["/usr/share/nodejs/typescript", "/usr/lib/node_modules/typescript"];
const place = places.find((path) => existsSync(path));
if (!place) {
  console.log("types.mjs: skipped: no TypeScript");
  process.exit(0);
}
const ts = createRequire(import.meta.url)(place);
const problems = [];

// ---- A program
const declarations = `${folder}/index.d.ts`;
const options = { strict: true, noEmit: true, target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.ES2022, types: [], baseUrl: ".", paths: { kerf: [declarations] } };
const program = ts.createProgram([use, declarations], options);
for (const found of ts.getPreEmitDiagnostics(program)) {
  const at = found.file?.getLineAndCharacterOfPosition(found.start);
  problems.push(`${found.file?.fileName}:${at?.line + 1}: ${ts.flattenDiagnosticMessageText(found.messageText, " ")}`);
}

// ---- Members, of the module and of the types
const checker = program.getTypeChecker();
const exported = checker.getExportsOfModule(checker.getSymbolAtLocation(program.getSourceFile(declarations)));
const k = await (await import(pathToFileURL(`${folder}/index.js`))).default();
const api = checker.getPropertiesOfType(checker.getDeclaredTypeOfSymbol(exported.find(({ name }) => name === "Kerf"))).map(({ name }) => name);
const compare = (what, module, types) => {
  for (const name of module) if (!types.includes(name)) problems.push(`${what}.${name}: the types lack it`);
  for (const name of types) if (!module.includes(name)) problems.push(`${what}.${name}: the module lacks it`);
};
compare("kerf", Object.keys(k), api);

// Members of a class and its bases; those of which the program may not know begin with an underline, or are `handle`.
function membersOf(cls) {
  const names = new Set();
  for (let proto = cls.prototype; proto && proto !== Object.prototype && proto !== Error.prototype; proto = Object.getPrototypeOf(proto))
    Object.getOwnPropertyNames(proto).forEach((name) => names.add(name));
  return [...names].filter((name) => !["constructor", "handle"].includes(name));
}
// Fields that a constructor sets are in no prototype.
const fields = { Plane: ["point", "normal"], Front: ["steps", "closed"], Score: ["sheet", "pieces", "chips", "attempts"], Breaking: ["finished"],
  BrokenPart: ["index", "solid", "parent", "volume", "centroid", "divided", "whole", "hulls"], KerfError: ["name", "message", "stack", "cause"] };
const loads = ["notes"];  // set by load() alone
let classes = 0;
for (const symbol of exported.filter(({ flags }) => flags & ts.SymbolFlags.Class)) {
  const types = checker.getPropertiesOfType(checker.getDeclaredTypeOfSymbol(symbol)).map(({ name }) => name).filter((name) => !name.startsWith("__@") && !loads.includes(name));
  const module = [...membersOf(k[symbol.name]), ...(fields[symbol.name] ?? [])];
  compare(symbol.name, symbol.name === "KerfError" ? types : module, types);
  classes++;
}

if (problems.length > 0) {
  console.error(problems.join("\n"));
  process.exit(1);
}
console.log(`types: ${classes} classes have the members of the module`);
