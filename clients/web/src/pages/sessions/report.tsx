// SPDX-License-Identifier: Apache-2.0
// The report of a session: the same pages and bytes as from `dtsctl report`.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import { Notice } from '../../parts/controls';
import { strings } from '../../strings';
import { archiveUrl, responseError, useAsked } from './asking';
import { Download } from './exports';

interface ReportIndex {
  readonly pages: readonly string[]; // HTML only; the pictures are inside
  readonly damage: readonly string[];
}

const words = (value: unknown): string[] => (Array.isArray(value) ? value.filter((one): one is string => typeof one === 'string') : []);

const askReport = async (sessionId: string, signal: AbortSignal): Promise<ReportIndex> => {
  const response = await fetch(archiveUrl(sessionId, 'report'), { signal });
  if (!response.ok) throw await responseError(response);
  const index = (await response.json()) as { pages?: unknown; damage?: unknown };
  return { pages: words(index.pages).filter((page) => page.endsWith('.html')), damage: words(index.damage) };
};

const pageName = (page: string): string => {
  const trial = /^trial-0*([0-9]+)/.exec(page)?.[1];
  return trial === undefined ? strings.sessions.report.session : strings.sessions.report.trial(trial);
};

/** Makes the frame as high as its page, so that only the page around it scrolls. */
const fitHeight = (frame: HTMLIFrameElement): void => {
  const page = frame.contentDocument?.documentElement as HTMLElement | null | undefined; // null while another page is loaded
  if (page) frame.style.height = `${page.scrollHeight + frame.offsetHeight - frame.clientHeight}px`; // with the border
};

/** A page of the report, without scripts. Same origin, because linked pages need the cookie of the login, and for its height. */
const ReportFrame = ({ title, url, testId }: { title: string; url: string; testId: string }): JSX.Element => {
  const frame = useRef<HTMLIFrameElement>(null);
  useEffect(() => {
    const observer = new ResizeObserver(() => fitHeight(frame.current!));
    observer.observe(frame.current!.parentElement!); // the width decides the height
    return () => observer.disconnect();
  }, []);
  return (
    <iframe
      ref={frame}
      class="report-frame"
      title={title}
      src={url}
      sandbox="allow-same-origin"
      scrolling="no"
      onLoad={(event) => fitHeight(event.currentTarget)}
      data-testid={testId}
    />
  );
};

export const Report = ({ sessionId, testId }: { sessionId: string; testId: string }): JSX.Element => {
  const { report } = strings.sessions;
  const asked = useAsked(`report ${sessionId}`, (signal) => askReport(sessionId, signal)).value;
  const chosen = useSignal<string | undefined>(undefined);
  if (asked.error !== undefined) return <Notice kind="plain" what={asked.error.message} hint={asked.error.hint} testId={`${testId}-error`} />;
  if (asked.answer === undefined) return <p data-testid={`${testId}-pending`}>{report.pending}</p>;
  const { pages, damage } = asked.answer;
  const page = chosen.value ?? pages[0];
  if (page === undefined) return <p>{report.none}</p>;
  const url = archiveUrl(sessionId, `report/${encodeURIComponent(page)}`);
  return (
    <div class="column" data-testid={testId}>
      {damage.map((sentence) => (
        <Notice key={sentence} kind="warning" what={sentence} testId={`${testId}-damage`} />
      ))}
      <div class="row" role="group" aria-label={report.pages}>
        {pages.map((name) => (
          <button key={name} type="button" class="button" aria-pressed={name === page} onClick={() => (chosen.value = name)}>
            {pageName(name)}
          </button>
        ))}
        <a class="button" href={url} target="_blank" rel="noopener" data-testid={`${testId}-print`}>
          {report.print}
        </a>
        <Download label={strings.report.pdf} url={archiveUrl(sessionId, 'report/report.pdf')} isPrepared={false} testId={`${testId}-pdf`} />
      </div>
      <ReportFrame title={report.title(sessionId)} url={url} testId={`${testId}-frame`} />
    </div>
  );
};
