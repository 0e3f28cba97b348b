// The only file that names the library's file. There is no bundler and, by the server's content
// security policy, no inline script, hence no import map.
export { Controller, GUI } from '../node_modules/lil-gui/dist/lil-gui.esm.min.js';
