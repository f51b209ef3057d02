// manifold's simplify(): node peerManifold.mjs MESH.off BOUND OUT.off, from a folder where
// `npm install manifold-3d` was run. Prints one JSON object.
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';

const [input, bound, output] = process.argv.slice(2);
const folder = resolve('node_modules/manifold-3d');
const {default: load} = await import(pathToFileURL(`${folder}/manifold.js`));
const {version} = JSON.parse(readFileSync(`${folder}/package.json`));
const manifold = await load();
manifold.setup();

const numbers = readFileSync(input, 'latin1').replace(/#.*/g, '').match(/[^\s]+/g).slice(1).map(Number);
const [points, triangles] = numbers;
const vertProperties = Float32Array.from(numbers.slice(3, 3 + 3 * points));
const triVerts = new Uint32Array(3 * triangles);
for (let t = 0, at = 3 + 3 * points; t < triangles; ++t, at += 4) triVerts.set(numbers.slice(at + 1, at + 4), 3 * t);

const began = process.cpuUsage();
const solid = new manifold.Manifold(new manifold.Mesh({numProp: 3, vertProperties, triVerts}));
const made = solid.simplify(Number(bound));
const spent = process.cpuUsage(began);

const mesh = made.getMesh(), lines = [`OFF\n${mesh.numVert} ${mesh.numTri} 0`];
for (let v = 0; v < mesh.numVert; ++v) lines.push(mesh.vertProperties.slice(3 * v, 3 * v + 3).join(' '));
for (let t = 0; t < mesh.numTri; ++t) lines.push(`3 ${mesh.triVerts.slice(3 * t, 3 * t + 3).join(' ')}`);
writeFileSync(output, lines.join('\n') + '\n');
console.log(JSON.stringify({version, cpuSeconds: (spent.user + spent.system) / 1e6, triangles: mesh.numTri}));
