// nii2mesh's chain as niimath has it: node peerNiimath.mjs IMAGE.nii ISOVALUE SHARE OUT.off, from a folder where
// `npm install @niivue/niimath` was run. Without smoothing, the largest piece, filled; SHARE of the triangles stays.
// Prints one JSON object.
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {gunzipSync} from 'node:zlib';

const [image, isovalue, share, output] = process.argv.slice(2);
const folder = resolve('node_modules/@niivue/niimath');
const {default: load} = await import(pathToFileURL(`${folder}/dist/niimath.js`));
const {version} = JSON.parse(readFileSync(`${folder}/package.json`));
const niimath = await load({print: () => {}});
niimath.FS_createDataFile('.', 'image.nii', readFileSync(image), true, true);
const options = ['-i', isovalue, '-l', '1', '-b', '1', '-p', '0', '-r', share];
const began = process.cpuUsage();
niimath.callMain(['image.nii', '-mesh', ...options, 'made.mz3']);
const spent = process.cpuUsage(began);

let bytes = Buffer.from(niimath.FS_readFile('made.mz3'));
if (bytes.readUInt16LE(0) === 0x8b1f) bytes = gunzipSync(bytes);
const [triangles, points, skipped] = [4, 8, 12].map((at) => bytes.readUInt32LE(at));
const corners = 16 + skipped, places = corners + 12 * triangles, lines = [`OFF\n${points} ${triangles} 0`];
const row = (count, read) => Array.from({length: count}, (_, n) => read(n)).join(' ');
for (let v = 0; v < points; ++v) lines.push(row(3, (n) => bytes.readFloatLE(places + 12 * v + 4 * n)));
for (let t = 0; t < triangles; ++t) lines.push('3 ' + row(3, (n) => bytes.readInt32LE(corners + 12 * t + 4 * n)));
writeFileSync(output, lines.join('\n') + '\n');
console.log(JSON.stringify({version, cpuSeconds: (spent.user + spent.system) / 1e6, triangles}));
