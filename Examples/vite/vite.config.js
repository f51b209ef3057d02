// The server of `vite dev` would move the package's modules away from their worker and WebAssembly.
export default { optimizeDeps: { exclude: ["adaptiso"] } };
