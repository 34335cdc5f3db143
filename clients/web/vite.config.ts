// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from 'vite';

// No inline code: the gateway's Content-Security-Policy is default-src 'self'.
export default defineConfig({
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  build: {
    target: 'es2022',
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rollupOptions: { output: { manualChunks: { german: ['src/strings/de/daemon.ts'] } } }, // the German of the daemon's messages changes rarely
  },
});
