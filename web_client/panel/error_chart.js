// The chart is shared with a page that may load no modules: this is the one place that names its scripts.
import '../report/error_chart.js';
import '../report/chart_view.js';

const shared = /** @type {any} */ (globalThis);

export const { errorChart, ErrorChartView } = shared;
