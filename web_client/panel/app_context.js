/**
 * What the tabs know of the rest of the client.
 * @typedef {object} AppContext
 * @property {import('../net/connection.js').Connection} connection
 * @property {import('../scene/scene_document.js').SceneDocument} document
 * @property {import('../scene/editor.js').Editor} editor
 * @property {import('../scene/edit_timer.js').EditTimer} timer
 * @property {import('../scene/selection.js').Selection} selection
 * @property {import('../view/camera.js').Camera} camera
 * @property {import('../view/picture.js').Picture} picture
 * @property {import('../view/comparison.js').Comparison} comparison
 * @property {import('../accuracy/measurement.js').Measurement} measurement
 * @property {import('../ui/toasts.js').Toasts} toasts
 * @property {import('../view/view_controls.js').ViewControls} view
 * @property {(group: string) => import('./parameter_controls.js').Parameter[]} parameters the
 *   server's table of a group
 * @property {(group: string, id?: number) => import('./parameter_controls.js').Target} target what
 *   the controls of a thing in the document show and edit
 * @property {(type: string) => void} addLight
 * @property {() => void} frameSelection
 */

export {};
