// Opens a page of web/ from its file in headless Chromium, refuses and records every other request, and records its
// errors.
import { pathToFileURL } from 'node:url';
import { launch } from './browser.mjs';

const DESKTOP = { width: 1280, height: 800 };

/** {page, faults, show(path), close()}: faults has what pages asked for, and their errors; show opens one in their place. */
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
    await page.goto(address);
    await page.waitForSelector('[data-ready], .fault', { timeout: 60_000 });
  };
  return { page, faults, show, close: () => browser.close() };
}

/** What the page says is the worst at the moment that it shows: degrees and vertex. */
export const worstNow = (page) => page.evaluate(() => {
  const { degrees, vertex } = document.querySelector('.now').dataset;
  return { degrees: Number(degrees), vertex: Number(vertex) };
});

/** Goes to the first of the worst places by a click on it. */
export async function clickWorst(page) {
  await page.evaluate(() => document.querySelector('.places button').click());
  return worstNow(page);
}
