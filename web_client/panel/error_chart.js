// A page that may load no modules shares the chart. This is the only file that names its scripts
// for modules.
import '../report/error_chart.js';
import '../report/chart_view.js';

const shared = /** @type {any} */ (globalThis);

export const { errorChart, ErrorChartView } = shared;
