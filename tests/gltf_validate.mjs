// Prints what the Khronos glTF validator finds in each file; exit code 1 when it finds anything.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const require = createRequire(`${process.env.TAFONI_NODE}/package.json`);
const validator = require('gltf-validator');
let found = 0;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {uri: file, maxIssues: 20});
  const {numErrors, numWarnings, numInfos, numHints, messages} = report.issues;
  found += numErrors + numWarnings + numInfos + numHints;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints`);
  for (const m of messages) console.log(`  ${m.code} at ${m.pointer ?? ''}: ${m.message}`);
}
process.exit(found ? 1 : 0);
