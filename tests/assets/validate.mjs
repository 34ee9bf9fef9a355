// validate.mjs FILE.glb...: Khronos' validator finds no error and no warning. Tangents of normal maps are left to readers.
import fs from 'node:fs';
import validator from 'gltf-validator';

for (const file of process.argv.slice(2)) {
  const options = {maxIssues: 0, ignoredIssues: ['MESH_PRIMITIVE_GENERATED_TANGENT_SPACE']};
  const {issues} = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), options);
  // Severity 0: errors, 1: warnings. It does not know the extensions, which is a piece of information.
  const found = issues.messages.filter(message => message.severity < 2);
  for (const message of found.slice(0, 5)) console.error(`${file}: ${message.code} at ${message.pointer}: ${message.message}`);
  if (issues.numErrors + issues.numWarnings > 0) process.exit(1);
}
console.log(`validator: ${process.argv.length - 2} files without error or warning`);
