// Opens a page of web/ as a file in headless Chromium. Refuses and records all other requests, and records the errors
// of the page.
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';

const DESKTOP = { width: 1280, height: 800 };

/** Opens a browser with a page. Returns {page, faults, show(path), close()}: `faults` has the requests and errors of
 * the page, and show() opens another page instead. */
export async function openPages() {
  const browser = await launch(), page = await browser.newPage(), faults = [];
  let address;
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (['error', 'warn'].includes(message.type()) && !/GPU stall|GL Driver Message/.test(message.text())) faults.push(message.text());
  });
  page.on('request', (request) => {
    if (request.url() === address || /^(data|blob):/.test(request.url())) return request.continue();
    faults.push(`asked for ${request.url()}`);
    return request.abort();
  });
  await page.setRequestInterception(true);
  await page.setViewport(DESKTOP);
  const show = async (path) => {
    address = pathToFileURL(path).href;
    await page.goto(address, { timeout: 120_000 });
    await page.waitForSelector('[data-ready], .fault', { timeout: 60_000 });
  };
  return { page, faults, show, close: () => browser.close() };
}

/** Returns the worst error at the moment that the page shows, in degrees, and its vertex. */
export const worstNow = (page) => page.evaluate(() => {
  const { degrees, vertex } = document.querySelector('.now').dataset;
  return { degrees: Number(degrees), vertex: Number(vertex) };
});

/** Clicks on the first entry in the list of worst places, which takes the page to that place. */
export async function clickWorst(page) {
  await page.evaluate(() => document.querySelector('.places button').click());
  return worstNow(page);
}
